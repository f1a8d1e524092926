"""The route said in plain words: edits of speech and manners, and which of them are taken back."""
