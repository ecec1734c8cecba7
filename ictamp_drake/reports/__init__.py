"""Statistics, tables and pages computed from records."""
