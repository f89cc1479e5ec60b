"""What `biped bag recover` does: a broken bag made sound, and what is lost counted."""
