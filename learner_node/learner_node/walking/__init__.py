"""XoL applied to the waist trajectory of a biped (Section 4)."""
