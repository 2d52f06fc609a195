"""Readers and writers of jobs."""
