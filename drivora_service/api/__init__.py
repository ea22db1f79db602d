"""HTTP: routes, request and response schemas, errors as problem details."""
