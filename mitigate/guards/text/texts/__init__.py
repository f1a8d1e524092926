"""What a text says: sentences, pieces, words, steps, and the evidence for or against a route."""
