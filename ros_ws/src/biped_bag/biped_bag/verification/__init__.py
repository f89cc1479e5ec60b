"""What `biped bag verify` does: a recorded learner answers again, and is compared."""
