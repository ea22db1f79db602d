"""ADSs in processes of their own: the gRPC protocol, its client and its server."""
