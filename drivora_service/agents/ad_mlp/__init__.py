"""An ADS that sees nobody: a perceptron of its own history and route, after AD-MLP."""
