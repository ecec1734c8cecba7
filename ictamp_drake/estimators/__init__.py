"""Estimators P of success, one file per implementation."""
