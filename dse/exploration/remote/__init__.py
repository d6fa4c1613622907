"""Work for other processes and machines: parcels that carry it, who carries them out, and who sends them."""
