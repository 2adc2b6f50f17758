"""What the rubber is: relaxation and creep, shift laws, the library."""
