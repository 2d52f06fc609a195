"""Readers and writers of jobs: files in, the words of `optplan.domain.job` out."""
