"""The agent that plans by nonlinear model-predictive control, with CasADi's symbolic framework."""
