"""Where campaigns run: in processes of a service, or in a command."""
