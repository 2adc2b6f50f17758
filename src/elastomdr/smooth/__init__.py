"""A smooth body that slides or rolls steadily."""
