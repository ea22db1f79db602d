"""AVFuzzer: a genetic algorithm with restarts and local searches around its best candidates."""
