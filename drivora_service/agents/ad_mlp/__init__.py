"""An ADS without perception of others: a perceptron on its history and route, after AD-MLP."""
