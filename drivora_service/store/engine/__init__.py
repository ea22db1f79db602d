"""Below all tables: connections, dialects, statements, pages, ids."""
