"""Tables of runs, evaluations and studies, and the forms that clients ask for."""
