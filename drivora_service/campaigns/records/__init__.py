"""What a campaign keeps: its journal, its folder, its row in the database."""
