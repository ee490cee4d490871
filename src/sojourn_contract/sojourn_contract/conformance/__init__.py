"""Judges messages by the contract, one by one, from any source: `judge.Judge`. Nothing in here reads bags."""
