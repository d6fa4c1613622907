"""Work for other processes and machines: messages that carry it, who carries them out, and who sends them."""
