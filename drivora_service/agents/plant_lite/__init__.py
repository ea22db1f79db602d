"""An ADS of object tokens and a transformer, after PlanT, trained here by imitation."""
