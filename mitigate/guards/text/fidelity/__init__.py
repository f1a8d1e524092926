"""What a change of an instruction may do: the gate, and what a text means, fact by fact."""
