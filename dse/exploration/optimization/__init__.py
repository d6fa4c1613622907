"""What searches for the best designs share: designs and the cases they are run in, judging, racing, and the front."""
