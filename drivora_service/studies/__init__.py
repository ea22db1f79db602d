"""Studies: figures and reports of campaigns, alone and compared."""
