"""Many runs of the whole graph, their values drawn from distributions, on one machine or on many."""
