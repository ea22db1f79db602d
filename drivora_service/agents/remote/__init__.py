"""ADSs with their own processes: the gRPC protocol, its client and its server."""
