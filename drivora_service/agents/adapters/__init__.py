"""Built-in ADSs with their own environments: manifests, requirements, adapters."""
