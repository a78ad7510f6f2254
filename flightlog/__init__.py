"""The flight log: topics, attachments, decisions, events, and their files."""
