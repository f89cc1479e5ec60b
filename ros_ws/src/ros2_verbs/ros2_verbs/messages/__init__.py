"""Messages: their types by name, shown as text, filled from text, filtered."""
