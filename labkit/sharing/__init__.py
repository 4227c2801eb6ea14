"""What a notebook shares with others: domains that others may join, and by what they meet."""
