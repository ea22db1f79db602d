"""The episode: libsumo, vehicle dynamics, followers, lights, perception, recorder."""
