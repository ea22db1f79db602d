"""The client of a command: of a service, or of the application in its own process."""
