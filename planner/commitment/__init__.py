"""One set of coasting times for a whole range of uncertainty: what the committed policy searches with."""
