"""AVFuzzer: a genetic algorithm that restarts where it stalls and searches around its bests."""
