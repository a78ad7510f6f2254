"""Text tables: their form, cells and headings."""
