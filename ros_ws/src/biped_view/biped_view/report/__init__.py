"""The walk report: one page that asks for nothing, figures, and an animation."""
