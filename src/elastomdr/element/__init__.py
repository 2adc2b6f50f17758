"""What one element does: Radok's operators, its law, relaxation moments, the contact
step.
"""
