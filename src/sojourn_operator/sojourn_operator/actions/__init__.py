"""Actions under which the front ends of others send goals: each goal goes on as one of the contract's."""
