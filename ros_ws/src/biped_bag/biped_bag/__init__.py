"""Bags: record, play, look into, verify, mend, cut and export them."""
