"""Flight log: topics, attachments, decisions, events and files."""
