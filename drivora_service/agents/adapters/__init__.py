"""Built-in ADSs that run in environments of their own: manifests, requirements, adapters."""
