"""What flight must be like, a sentence a test."""
