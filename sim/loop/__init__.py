"""The simulation loop: signals, streams of random numbers, numeric back-ends."""
