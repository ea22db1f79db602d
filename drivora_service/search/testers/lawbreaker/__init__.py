"""LawBreaker: breeds from the scenarios nearest to each uncovered violation of a traffic law."""
