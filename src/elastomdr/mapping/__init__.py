"""What three dimensions become on the line: Radok's operators, MDR profiles, the direction average."""
