"""DeepCollision: an adversary that acts during the runs and learns by deep Q-learning."""
