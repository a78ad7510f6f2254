"""Results as text: review, scorecard, thesis."""
