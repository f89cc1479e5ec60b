"""The verbs of `biped bag`, one module each."""
