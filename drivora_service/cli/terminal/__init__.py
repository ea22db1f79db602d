"""What all commands share: options, output, tables, files that they write."""
