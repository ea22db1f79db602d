"""DiLu behind the protocol: a language model decides once a second, with examples from a memory."""
