"""SAMOTA: many objectives searched with the help of surrogates."""
