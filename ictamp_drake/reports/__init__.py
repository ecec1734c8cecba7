"""Statistics, tables and pages made from records."""
