"""Every operation of the API, once; each client has a method of the same name."""
