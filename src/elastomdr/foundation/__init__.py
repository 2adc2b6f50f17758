"""What one element of the line does: its law, the relaxation moments of a passage, the exact contact step."""
