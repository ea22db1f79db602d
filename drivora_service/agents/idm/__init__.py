"""The intelligent-driver agent: IDM along the route, pure pursuit, lights and right of way."""
